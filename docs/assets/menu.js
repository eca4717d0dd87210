// The menu is longer than the window: show the entry of this page.
document.addEventListener("DOMContentLoaded", () => {
  const menu = document.querySelector(".sidebar-scroll");
  const entry = menu?.querySelector(".current-page");
  if (entry) menu.scrollTop += entry.getBoundingClientRect().top - menu.getBoundingClientRect().top - menu.clientHeight / 3;
});
