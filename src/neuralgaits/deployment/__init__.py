"""The deployment file: how a robot file's joints meet motors, sensors and their signs."""
