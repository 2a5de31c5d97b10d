"""Reports of split Hopkinson bars: a shot, an accelerometer on a bar end, a bar calibrated by its echoes."""
