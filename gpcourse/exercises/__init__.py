"""Layer 2: what is asked and how it is judged, a module a chapter."""
