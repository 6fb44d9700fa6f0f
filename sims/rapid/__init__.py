"""A RAPID interpreter: source in, tasks that run on the loop's time out."""
