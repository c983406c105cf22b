"""The interactive page: one HTML file in which a record plays, and its controller can be changed."""

from fuzzyq_bullet.page.document import MARK, lesson_page, record_page

__all__ = ["MARK", "lesson_page", "record_page"]
