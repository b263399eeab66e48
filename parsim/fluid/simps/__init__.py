"""Semi-implicit moving particles (Amaro et al. 2021), the pressure by an equation for all water and bodies at once."""
