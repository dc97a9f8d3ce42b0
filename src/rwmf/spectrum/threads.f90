!> Number of threads of a spectrum.
!>
!> Unreasonably large numbers are refused: if the system cannot start a thread, the OpenMP library
!> ends the program.
module rwmf_spectrum_threads
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_text_strings, only: integer_to_text
   !$ use omp_lib, only: omp_get_max_threads, omp_get_num_procs
   implicit none
   private

   public :: choose_threads, most_threads

contains

   !> Choose the number of threads.
   !>
   !> Fails with `err_input` if the number is negative or above `most_threads`.
   subroutine choose_threads(request, threads, error)
      integer, intent(in) :: request
      !! number of threads; 0 for all that OpenMP offers, limited by OMP_NUM_THREADS
      integer, intent(out) :: threads
      !! >= 1
      type(error_t), allocatable, intent(out) :: error
      integer :: most

      most = most_threads()
      threads = max(1, request)
      !$ if (request == 0) threads = omp_get_max_threads()
      if (request >= 0 .and. threads >= 1 .and. threads <= most) return
      if (request /= 0) then
         call fail(error, err_input, 'threads = '//trim(integer_to_text(request)) &
            //': must be 0 (all) to '//trim(integer_to_text(most))//' on this machine')
      else
         call fail(error, err_input, 'OMP_NUM_THREADS = '//trim(integer_to_text(threads)) &
            //': must be <= '//trim(integer_to_text(most))//' on this machine')
      end if
   end subroutine choose_threads

   !> Largest allowed number of threads on this machine.
   !>
   !> This is 16 for each processor that the process may use, and at least 256.
   integer function most_threads()
      integer, parameter :: always = 256
      integer, parameter :: for_each_processor = 16

      most_threads = always
      !$ most_threads = max(always, for_each_processor*omp_get_num_procs())
   end function most_threads

end module rwmf_spectrum_threads
