"""Export of a trained gait as a C controller: written from its Programs, compared with Python."""
