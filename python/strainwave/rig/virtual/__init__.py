"""A rig that exists in numbers only: pictures of a target, and a gear under the steps of a test, whose truth is known."""
