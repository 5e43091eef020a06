"""Animals: cats and dogs that are made on this machine by rules, from a row of numbers each."""
