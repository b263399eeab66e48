"""What is measured of a run: `observers` lists what is, `sensors` what a case may place."""
