"""What the rows say: tables, statistics, comparisons."""
