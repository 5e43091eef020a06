"""How people hold and move their limbs: pure functions from skeletons and time to postures."""
