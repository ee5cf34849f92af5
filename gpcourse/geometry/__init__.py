"""Layer 0: arrays, meshes, shapes and files. Knows nothing of a course.

Nothing in here solves an exercise: a student's process may import this package.
"""
