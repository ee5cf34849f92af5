"""Layer 1: running a student's function, here or in another process.

Nothing in here knows of exercises, checks or solutions: the worker process that student
code runs in holds this package and `gpcourse.geometry`, and no other part of gpcourse.
"""
