"""What water and bodies do to each other: samples of bodies, films in thin gaps."""
