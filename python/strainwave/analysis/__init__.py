"""What a drive is like without running it at length: steady and linear views, responses, derivatives."""
