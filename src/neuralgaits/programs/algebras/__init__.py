"""Numbers that a Program can be evaluated in: points, Taylor models, balls."""
