"""A stand-in for the parts of PsychoPy that pages and plug-in use: no window opens, and each question is answered at once."""
