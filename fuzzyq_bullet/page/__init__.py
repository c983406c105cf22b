"""The interactive page: one HTML file that plays a record and lets its controller be changed."""

from fuzzyq_bullet.page.document import MARK, lesson_page, record_page

__all__ = ["MARK", "lesson_page", "record_page"]
