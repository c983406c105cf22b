"""The paper's planners beside those of the field, in fields of six kinds or a user's worlds."""
