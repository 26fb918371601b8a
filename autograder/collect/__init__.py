"""
The command ``collect``: copy delivered notebooks to the folder that nbgrader reads.

Each file is written atomically and the source is only read.  One table lists everything that was
found: what was collected, what was not, and why.  Running the command again changes nothing.

``tree`` lists a source, ``kinds`` finds out who handed in what, ``choice`` selects the notebook,
and ``write_copy`` writes it.  A student's id depends only on the name in the source (``ids``);
if two people have the same name, ``namesakes`` stops.  In nbgrader's exchange any user can hand in
under any name, so ``owners`` compares the name with the owner.
"""
