"""Small widgets that panels, views, editors and dialogs share."""
