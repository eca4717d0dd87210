"""A trained gait as a C controller: written from its Programs, compiled, compared with Python."""
