"""Run the visible checks of a student's repository on push, and report them to GitHub."""
