!> Text files that appear complete or not at all.
!>
!> Lines go to a temporary file in the folder of the target, which is renamed when everything has
!> reached the disk. A failure (no permission, full disk) removes the temporary file and leaves an
!> earlier target untouched. C streams are used because `close` of gfortran does not report a
!> failed last write.
module rwmf_text_atomic_file
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_null_char, c_null_ptr, &
      c_ptr, c_size_t
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: i8
   use rwmf_text_file, only: c_fclose, c_fopen
   implicit none
   private

   public :: atomic_file_t, open_atomic, write_line, finish, publish, discard
   public :: check_folder, join_path

   !> A file that is being written.
   type :: atomic_file_t
      private
      type(c_ptr) :: stream = c_null_ptr
      !! C stream of the temporary file; null when it is not open
      character(:), allocatable :: path
      !! the target
      character(:), allocatable :: temporary
      !! name of the temporary file; unallocated when there is none
   end type atomic_file_t

   ! allow(assumed-size): that is what a C string is
   interface
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

      function c_getpid() bind(c, name='getpid') result(pid)
         import :: c_int
         implicit none
         integer(c_int) :: pid
      end function c_getpid
   end interface

contains

   !> Start a file. Fails when its folder does not exist or cannot be written.
   subroutine open_atomic(file, path, error)
      type(atomic_file_t), intent(out) :: file
      character(*), intent(in) :: path
      !! the target; an earlier file of this name stays until `publish`
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: tries = 100
      character(:), allocatable :: temporary
      integer :: i

      call check_folder(folder_of(path), error)
      if (allocated(error)) then
         error%message = 'cannot write '//path//': '//error%message
         return
      end if
      do i = 1, tries
         call name_temporary(path, i, temporary)
         ! 'x' refuses an existing file: another thread or process may write the same target
         file%stream = c_fopen(temporary//c_null_char, 'wbx'//c_null_char)
         if (c_associated(file%stream)) exit
      end do
      if (.not. c_associated(file%stream)) then
         call fail(error, err_input, 'cannot write '//path//': its folder takes no new file')
         return
      end if
      file%path = path
      file%temporary = temporary
   end subroutine open_atomic

   !> Add a line. A failure stays with the stream and is reported by `finish`.
   subroutine write_line(file, line)
      type(atomic_file_t), intent(in) :: file
      character(*), intent(in) :: line
      !! without the line feed
      integer(c_size_t) :: written

      written = c_fwrite(line//new_line('a'), 1_c_size_t, len(line, c_size_t) + 1_c_size_t, &
         file%stream)
   end subroutine write_line

   !> Write what is still buffered and close. On failure the temporary file is removed.
   subroutine finish(file, error)
      type(atomic_file_t), intent(inout) :: file
      type(error_t), allocatable, intent(out) :: error
      logical :: failed

      ! an error before, or that of writing what `fclose` still finds in the buffer
      failed = c_ferror(file%stream) /= 0_c_int
      failed = c_fclose(file%stream) /= 0_c_int .or. failed
      file%stream = c_null_ptr
      if (failed) then
         call discard(file)
         call fail(error, err_input, 'cannot write '//file%path//': the disk may be full')
      end if
   end subroutine finish

   !> Give a finished file its name. On failure the temporary file is removed.
   subroutine publish(file, error)
      type(atomic_file_t), intent(inout) :: file
      type(error_t), allocatable, intent(out) :: error

      if (c_rename(file%temporary//c_null_char, file%path//c_null_char) /= 0_c_int) then
         call discard(file)
         call fail(error, err_input, 'cannot write '//file%path//': the name cannot be replaced')
      else
         deallocate (file%temporary)
      end if
   end subroutine publish

   !> Drop a file that has not been published; harmless when there is none.
   subroutine discard(file)
      type(atomic_file_t), intent(inout) :: file
      integer(c_int) :: status

      ! the statuses do not matter: nothing else can be done about a file that is dropped
      if (c_associated(file%stream)) status = c_fclose(file%stream)
      file%stream = c_null_ptr
      if (allocated(file%temporary)) then
         status = c_unlink(file%temporary//c_null_char)
         deallocate (file%temporary)
      end if
   end subroutine discard

   !> Can files be created in this folder? Asked before a long computation starts.
   subroutine check_folder(folder, error)
      character(*), intent(in) :: folder
      !! '' is the current one
      type(error_t), allocatable, intent(out) :: error
      integer(c_int), parameter :: exists = 0_c_int, writable_and_searchable = 3_c_int
      character(:), allocatable :: path

      path = join_path(folder, '.')//c_null_char
      if (c_access(path, exists) /= 0_c_int) then
         call fail(error, err_input, 'the folder '//folder//' does not exist')
      else if (c_access(path, writable_and_searchable) /= 0_c_int) then
         call fail(error, err_input, 'the folder '//folder//' is not writable')
      end if
   end subroutine check_folder

   !> `folder/name`, where the folder may be '' (the current one).
   pure function join_path(folder, name) result(path)
      character(*), intent(in) :: folder
      character(*), intent(in) :: name
      character(len(folder) + len(name) + merge(1, 0, &
         index(folder, '/', back=.true.) < len(folder))) :: path

      path = folder//repeat('/', len(path) - len(folder) - len(name))//name
   end function join_path

   !> What stands before the last slash, with it; '' when there is none.
   pure function folder_of(path) result(folder)
      character(*), intent(in) :: path
      character(index(path, '/', back=.true.)) :: folder

      folder = path
   end function folder_of

   !> A hidden name beside the target that no other process or thread is likely to use.
   subroutine name_temporary(path, attempt, name)
      character(*), intent(in) :: path
      integer, intent(in) :: attempt
      !! 1, 2, ...: a new name for every attempt
      character(:), allocatable, intent(out) :: name
      character(48) :: unique
      integer(i8) :: ticks

      call system_clock(ticks)
      write (unique, '(i0, "-", i0, "-", i0)') c_getpid(), ticks, attempt
      name = folder_of(path)//'.'//path(len(folder_of(path)) + 1:)//'.'//trim(unique)//'.tmp'
   end subroutine name_temporary

end module rwmf_text_atomic_file
