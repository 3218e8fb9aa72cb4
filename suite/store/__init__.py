"""What a run has left: its folder, its journal, its rows as frames."""
