!> Text files that appear complete or not at all.
!>
!> Lines are written to a new file in the folder of the target. When all data are on the disk, the
!> new file takes the target's name: write, fsync, rename, fsync of the folder. A failure (no
!> permission, full disk) removes the new file and leaves an earlier target untouched. If the path
!> is a link, its target is replaced and the link stays. Lines for a pipe, a device or an open
!> descriptor such as /dev/stdout are written directly. docs/reference/files.md has the rules. C
!> streams are used because `close` of gfortran does not report a failed last write.
module rwmf_text_atomic_file
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_loc, c_null_char, &
      c_null_ptr, c_ptr, c_size_t
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_text_file, only: c_fclose
   implicit none
   private

   public :: atomic_file_t, open_atomic, write_line, finish, publish, discard
   public :: check_folder, check_not_folder, check_not_read, join_path, remove_leftovers, c_fileno

   !> File that is being written.
   type :: atomic_file_t
      private
      type(c_ptr) :: stream = c_null_ptr
      !! C stream of the new file; null when it is not open
      character(:), allocatable :: path
      !! the target as the caller gave it
      character(:), allocatable :: target
      !! the target with all links resolved
      character(:), allocatable :: temporary
      !! name of the new file; unallocated when there is none
   end type atomic_file_t

   integer, parameter :: longest_path = 4096
   !! number of characters, including the terminating null of C

   ! results of `rwmf_find_target`
   integer(c_int), parameter :: written_through = 1_c_int, refused = -1_c_int

   ! allow(assumed-size): C strings are arrays of assumed size
   interface
      function c_fdopen(descriptor, mode) bind(c, name='fdopen') result(stream)
         import :: c_char, c_int, c_ptr
         implicit none
         integer(c_int), intent(in), value :: descriptor
         character(kind=c_char), intent(in) :: mode(*)
         type(c_ptr) :: stream
      end function c_fdopen

      function c_fwrite(bytes, size, count, stream) bind(c, name='fwrite') result(written)
         import :: c_char, c_ptr, c_size_t
         implicit none
         character(kind=c_char), intent(in) :: bytes(*)
         integer(c_size_t), intent(in), value :: size
         integer(c_size_t), intent(in), value :: count
         type(c_ptr), intent(in), value :: stream
         integer(c_size_t) :: written
      end function c_fwrite

      function c_ferror(stream) bind(c, name='ferror') result(status)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), intent(in), value :: stream
         integer(c_int) :: status
      end function c_ferror

      function c_fflush(stream) bind(c, name='fflush') result(status)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), intent(in), value :: stream
         integer(c_int) :: status
      end function c_fflush

      function c_fileno(stream) bind(c, name='fileno') result(descriptor)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), intent(in), value :: stream
         integer(c_int) :: descriptor
      end function c_fileno

      function c_fsync(descriptor) bind(c, name='fsync') result(status)
         import :: c_int
         implicit none
         integer(c_int), intent(in), value :: descriptor
         integer(c_int) :: status
      end function c_fsync

      function c_rename(old, new) bind(c, name='rename') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: old(*)
         character(kind=c_char), intent(in) :: new(*)
         integer(c_int) :: status
      end function c_rename

      function c_unlink(path) bind(c, name='unlink') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function c_unlink

      function c_access(path, mode) bind(c, name='access') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), intent(in), value :: mode
         integer(c_int) :: status
      end function c_access

      function c_find_target(path, target, size) bind(c, name='rwmf_find_target') result(answer)
         import :: c_char, c_int, c_ptr
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         type(c_ptr), intent(in), value :: target
         integer(c_int), intent(in), value :: size
         integer(c_int) :: answer
      end function c_find_target

      function c_open_through(target) bind(c, name='rwmf_open_through') result(descriptor)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: target(*)
         integer(c_int) :: descriptor
      end function c_open_through

      function c_create_new(folder, path, size) bind(c, name='rwmf_create_new') &
         result(descriptor)
         import :: c_char, c_int, c_ptr
         implicit none
         character(kind=c_char), intent(in) :: folder(*)
         type(c_ptr), intent(in), value :: path
         integer(c_int), intent(in), value :: size
         integer(c_int) :: descriptor
      end function c_create_new

      function c_sync_folder(folder) bind(c, name='rwmf_sync_folder') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: folder(*)
         integer(c_int) :: status
      end function c_sync_folder

      function c_is_same_file(path, other) bind(c, name='rwmf_is_same_file') result(is_same)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(in) :: other(*)
         integer(c_int) :: is_same
      end function c_is_same_file

      subroutine c_remove_leftovers(folder) bind(c, name='rwmf_remove_leftovers')
         import :: c_char
         implicit none
         character(kind=c_char), intent(in) :: folder(*)
      end subroutine c_remove_leftovers
   end interface

contains

   !> Open a new file for writing. Fails if its folder does not exist or is not writable.
   subroutine open_atomic(file, path, error)
      type(atomic_file_t), intent(out) :: file
      character(*), intent(in) :: path
      !! the target; an earlier file of this name stays until `publish`
      type(error_t), allocatable, intent(out) :: error
      character(longest_path), target :: buffer
      integer(c_int) :: answer
      integer(c_int) :: descriptor

      answer = c_find_target(path//c_null_char, c_loc(buffer), int(len(buffer), c_int))
      if (answer == refused) then
         call fail(error, err_input, 'cannot write '//path//': the name is too long, or a link ' &
            //'of another user in a folder that all may write')
         return
      end if
      file%path = path
      file%target = buffer(:index(buffer, c_null_char) - 1)
      if (answer == written_through) then
         descriptor = c_open_through(file%target//c_null_char)
      else
         call check_folder(folder_of(file%target), error)
         if (allocated(error)) then
            error%message = 'cannot write '//path//': '//error%message
            return
         end if
         descriptor = c_create_new(folder_of(file%target)//c_null_char, c_loc(buffer), &
            int(len(buffer), c_int))
         if (descriptor >= 0_c_int) file%temporary = buffer(:index(buffer, c_null_char) - 1)
      end if
      if (descriptor >= 0_c_int) file%stream = c_fdopen(descriptor, 'w'//c_null_char)
      if (.not. c_associated(file%stream)) then
         call discard(file)
         call fail(error, err_input, 'cannot write '//path//': its folder takes no new file')
      end if
   end subroutine open_atomic

   !> Add a line. The stream keeps a failure until `finish` reports it.
   subroutine write_line(file, line)
      type(atomic_file_t), intent(in) :: file
      character(*), intent(in) :: line
      !! without the line feed
      integer(c_size_t) :: written

      written = c_fwrite(line, 1_c_size_t, len(line, c_size_t), file%stream)
      written = c_fwrite(new_line('a'), 1_c_size_t, 1_c_size_t, file%stream)
   end subroutine write_line

   !> Flush all lines to the disk. On failure the new file is removed.
   subroutine finish(file, error)
      type(atomic_file_t), intent(inout) :: file
      type(error_t), allocatable, intent(out) :: error
      logical :: failed

      ! an earlier error, or a failure to write the rest of the buffer
      failed = c_ferror(file%stream) /= 0_c_int
      failed = c_fflush(file%stream) /= 0_c_int .or. failed
      if (allocated(file%temporary)) then
         failed = c_fsync(c_fileno(file%stream)) /= 0_c_int .or. failed
      end if
      if (.not. failed) return
      call discard(file)
      call fail(error, err_input, 'cannot write '//file%path &
         //': the disk may be full, or the file larger than is allowed')
   end subroutine finish

   !> Rename a finished file to its target and close it. On failure the new file is removed.
   subroutine publish(file, error)
      type(atomic_file_t), intent(inout) :: file
      type(error_t), allocatable, intent(out) :: error
      logical :: failed

      if (allocated(file%temporary)) then
         ! Rename before closing: the lock keeps other runs from removing it as a leftover.
         failed = c_rename(file%temporary//c_null_char, file%target//c_null_char) /= 0_c_int
         if (failed) then
            call fail(error, err_input, 'cannot write '//file%path &
               //': the name cannot be replaced')
         else
            deallocate (file%temporary)
            if (c_sync_folder(join_path(folder_of(file%target), '.')//c_null_char) &
               /= 0_c_int) then
               call fail(error, err_input, 'cannot write '//file%path//': the disk fails')
            end if
         end if
      end if
      call discard(file)
   end subroutine publish

   !> Close a file and delete it if it has not been published; harmless if no file is open.
   subroutine discard(file)
      type(atomic_file_t), intent(inout) :: file
      integer(c_int) :: status

      ! The statuses are ignored: published data are already on the disk.
      if (c_associated(file%stream)) status = c_fclose(file%stream)
      file%stream = c_null_ptr
      if (allocated(file%temporary)) then
         status = c_unlink(file%temporary//c_null_char)
         deallocate (file%temporary)
      end if
   end subroutine discard

   !> Check that files can be created in a folder, before a long computation starts.
   subroutine check_folder(folder, error)
      character(*), intent(in) :: folder
      !! '' is the current one
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if no file can be created
      integer(c_int), parameter :: exists = 0_c_int, writable_and_searchable = 3_c_int
      character(:), allocatable :: path

      path = join_path(folder, '.')//c_null_char
      if (c_access(path, exists) /= 0_c_int) then
         call fail(error, err_input, 'the folder '//folder//' does not exist')
      else if (c_access(path, writable_and_searchable) /= 0_c_int) then
         call fail(error, err_input, 'the folder '//folder//' is not writable')
      end if
   end subroutine check_folder

   !> Check that the path of an output file is not a folder.
   subroutine check_not_folder(path, error)
      character(*), intent(in) :: path
      !! of the file
      type(error_t), allocatable, intent(out) :: error
      !! `err_input`
      integer(c_int), parameter :: exists = 0_c_int

      if (c_access(path//'/.'//c_null_char, exists) /= 0_c_int) return
      call fail(error, err_input, 'cannot write '//path//': it is a folder')
   end subroutine check_not_folder

   !> Path `folder/name`, where the folder may be '' (the current one).
   pure function join_path(folder, name) result(path)
      character(*), intent(in) :: folder
      !! its path; '' is the current one
      character(*), intent(in) :: name
      !! of the file, without folder
      character(len(folder) + len(name) + merge(1, 0, &
         index(folder, '/', back=.true.) < len(folder))) :: path

      path = folder//repeat('/', len(path) - len(folder) - len(name))//name
   end function join_path

   !> Part of a path up to and including its last slash; '' if it has none.
   pure function folder_of(path) result(folder)
      character(*), intent(in) :: path
      character(index(path, '/', back=.true.)) :: folder

      folder = path
   end function folder_of

   !> Check that an output file is not also an input file of the run, even under another name.
   !> Fails with `err_input` if it is.
   subroutine check_not_read(path, input, error)
      character(*), intent(in) :: path
      !! output file
      character(*), intent(in) :: input
      !! input file
      type(error_t), allocatable, intent(out) :: error

      if (c_is_same_file(path//c_null_char, input//c_null_char) == 0_c_int) return
      call fail(error, err_input, 'cannot write '//path//': it is read by this run, as '//input)
   end subroutine check_not_read

   !> Remove the unfinished files that killed runs of this user have left in a folder.
   subroutine remove_leftovers(folder)
      character(*), intent(in) :: folder
      !! '' is the current one

      call c_remove_leftovers(join_path(folder, '.')//c_null_char)
   end subroutine remove_leftovers

end module rwmf_text_atomic_file
