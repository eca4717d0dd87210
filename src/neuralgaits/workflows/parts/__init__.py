"""What several verbs are put together from, or each row of a sweep."""
