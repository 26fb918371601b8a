"""
The command ``collect``: copy handed-in notebooks to the folder that nbgrader reads.

Files are written atomically, and the source is never changed.  A table shows for every entry of
the source whether it was collected, or why not.  Running the same command again changes nothing.

``deliveries`` lists the files, ``recognise`` finds the platform (``platforms``) and who handed in
what, ``selection`` selects the notebooks, and ``copy_notebooks`` copies them.  A student's id
depends only on the name in the source.  If two people have the same name, ``duplicate_names``
refuses their work.  In nbgrader's exchange, any user can hand in under any name, so ``owners``
compares the student with the owner of the files.
"""
