"""Split Hopkinson bars: a shot, an accelerometer on a bar end, or a bar alone; set-up file in, solution out."""
