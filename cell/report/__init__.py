"""What a run leaves for people: a table, a page, pictures."""
