"""The planners of the paper beside those of the field, in fields of six kinds or a user's worlds."""
