"""A stand-in for pyserial, which PsychoPy brings along."""
