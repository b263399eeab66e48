"""Many runs of one case: what is varied, what each run is asked, and what follows of all of them."""
