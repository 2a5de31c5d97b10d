"""A machine strikes an object: blow after blow, with what its layers and sensors show."""
