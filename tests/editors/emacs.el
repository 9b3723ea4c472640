;;; emacs.el --- Prints what Emacs shows of a scene  -*- lexical-binding: t -*-
;;; Commentary:
;; Started by tests/editors.rs.
;;; Code:

(defun wait-for (condition)
  "Wait until CONDITION returns a value, at most twenty seconds."
  (with-timeout (20 nil)
    (while (not (funcall condition))
      (accept-process-output nil 0.05))
    t))

(find-file "scene.ron")
(princ (format "mode: %s\n" major-mode))
;; Without a terminal, no command runs.
(run-hooks 'post-command-hook)
(wait-for #'eglot-current-server)
(flymake-start)
(wait-for #'flymake-diagnostics)
(dolist (fault (flymake-diagnostics))
  (princ (format "fault: %s\n" (flymake-diagnostic-text fault))))
(search-forward "fov")
(backward-char)
(let ((answer (jsonrpc-request (eglot-current-server) :textDocument/hover
                               (eglot--TextDocumentPositionParams))))
  (princ (format "hover: %s\n" (plist-get (plist-get answer :contents) :value))))
(set-buffer-modified-p nil)
(kill-emacs)
;;; emacs.el ends here
