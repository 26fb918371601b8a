"""
The command ``collect``: copy handed-in notebooks to the folder that nbgrader reads.

Files are written atomically, and the source is never changed.  A table shows for every entry of
the source whether it was collected, or why not.  Running the same command again changes nothing.

``deliveries`` lists the files, ``recognise`` finds the platform (``platforms``) and who handed in
what, ``owners`` refuses work of two people with one name and of other users, ``selection`` selects
the notebooks, and ``copy_notebooks`` copies them.  A student's id depends only on the name in the
source.
"""
