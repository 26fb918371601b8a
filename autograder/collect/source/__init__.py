"""Read a source: files of a folder or a zip, who delivered them, and when."""
