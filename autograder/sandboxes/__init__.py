"""Where student code runs, what it may use there, and what that mode does not protect."""
