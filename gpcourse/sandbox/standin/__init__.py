"""Sources of the reduced package that student code finds as `gpcourse` while it is graded.

`home.build` copies them, with the geometry layer, into a folder of its own. Nothing imports them from here.
"""
