"""Any case over any of its settings: numbers of each run, pictures of them, and the main effect of each setting."""
