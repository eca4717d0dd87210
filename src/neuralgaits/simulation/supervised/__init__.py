"""The supervisor of an exported controller in MuJoCo: a robot that stands, walks and stops."""
