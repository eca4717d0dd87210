"""Data of a gait for figures, report and viewer: its flow, its orbit, its quantities."""
