"""The cost model of a step, fitted to measurements."""
