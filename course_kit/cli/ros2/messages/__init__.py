"""Messages as text, and text into messages, as the commands take and print them."""
