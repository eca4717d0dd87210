"""One file a verb: each composes the rooms above into something a user asks for."""
