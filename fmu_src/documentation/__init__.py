"""What an FMU says of itself to people: documentation/index.html, its licences and model.png, laid out as FMI asks."""
