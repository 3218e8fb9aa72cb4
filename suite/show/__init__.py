"""What people look at: text, terminal, derived files."""
