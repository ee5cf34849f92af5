"""Layer 1: the solutions, a module a chapter. Later chapters may import earlier ones."""
