"""What figures, report and viewer show of a gait: its flow, its orbit, its quantities."""
