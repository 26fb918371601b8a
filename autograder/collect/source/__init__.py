"""What is in a source: files of a folder or a zip, who handed them in, and when."""
