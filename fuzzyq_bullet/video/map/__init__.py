"""The map: everything from straight above, with the way so far."""
