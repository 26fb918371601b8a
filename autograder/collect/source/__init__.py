"""Read a source: the files of a folder or zip, the students, and the times of delivery."""
