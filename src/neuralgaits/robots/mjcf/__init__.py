"""Robot files: read as a planar biped, or changed into one that can be."""
