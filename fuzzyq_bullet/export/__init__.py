"""A record in the forms that other programs show it in."""
