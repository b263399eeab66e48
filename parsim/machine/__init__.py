"""What the machine gives: compiler, kernel variants, their cache, clocks."""
