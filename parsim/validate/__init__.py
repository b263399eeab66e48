"""How true runs are: example cases against published and exact numbers, with bars that they have to meet."""
